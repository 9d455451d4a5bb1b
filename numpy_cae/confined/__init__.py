"""A process for code that nobody vouches for, such as a student's file.

`confinement` limits what the process may do, by means of the system. `channel` lets two processes
call functions of each other: only numbers, texts, arrays and references to functions go through
it. `process` is what runs in the confined process: a fork of a `template`, or a `program` where
there is none. Nothing here imports the rest of numpy_cae, so that the confined process holds no
solution of an exercise. `python -m numpy_cae.confined` runs a grader with a template.
"""
