"""Where the robot should be and how hard it should press: trajectories, planners, posture, haptic exploration."""
