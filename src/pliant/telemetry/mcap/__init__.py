"""Logs as MCAP files with ROS 2 messages."""
