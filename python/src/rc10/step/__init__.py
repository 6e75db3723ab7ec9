"""Step responses: `python -m rc10.step MOTOR velocity 100`, and its parts for programs.

`rc10.step.run.run_step()` runs a step on a live robot, `rc10.step.analysis.analyse()` judges any
response.
"""
