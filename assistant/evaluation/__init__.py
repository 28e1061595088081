"""The paper's four experiments on simulated or given recordings, and their report.

Questions go through the real grammar, planner and stores; the truth is joined afterwards.
"""
