"""Plots of signals: figures of recordings, and `python -m rc10.plot` of a live robot."""
