"""A student's file runs in a process of its own: `process` starts it, `child` is what it runs.

The process tests the file's functions itself and sends back one line of JSON for each. It has
limits on time, memory and the number of processes, a NumPy of its own, so that what the file
changes there does not reach the tests, and no import of this project or of a library that
differentiates.

This protects against mistakes and shortcuts, not against an attack. A file can read and delete
whatever its user can, use the network, read the solutions in the project's source, or find the
tests in the memory of its process. Grade files of people you do not trust in a container.
"""
