"""A stranger's file, run where it can do no harm to the one who grades it.

The file runs in a process of its own, with limits on time and memory. The grader's process never
imports it: it sends arrays over and gets arrays back, and every judgement is made on this side.
This guards against accidents and shortcuts, not against a program that means to attack the
machine: the process has its user's rights.
"""
