"""A student's file is graded in processes of its own, by tests that run beside its functions.

`process` starts `child`, in bubblewrap where that works. `child` reads the file and forks a
process for each function (`apart`), which loads the file, tests the function and sends one reply;
`confinement` limits what it can do, and gives it copies of all modules.

This protects against mistakes and shortcuts, not against an attack: a file can read whatever its
user can, the solutions in this project's source among it, and find the tests in the memory of its
process. Grade files of people you do not trust in a container, and not as root.
"""
