"""Log files of lcm-logger as tables and as MCAP: `python -m rc10.export LOG`."""
