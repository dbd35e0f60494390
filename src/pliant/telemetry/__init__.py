"""Logs, metrics, tables and figures of runs."""

from pliant.telemetry.channels import Channel
from pliant.telemetry.info import RunInfo
from pliant.telemetry.log import Log, LogChannel
from pliant.telemetry.output import output_folder
from pliant.telemetry.recorder import Recorder
from pliant.telemetry.summary import CaseSummary, Metric, Summary, over_runs

__all__ = [
    "CaseSummary",
    "Channel",
    "Log",
    "LogChannel",
    "Metric",
    "Recorder",
    "RunInfo",
    "Summary",
    "output_folder",
    "over_runs",
]
