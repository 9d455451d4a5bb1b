"""The marks of a class: who handed what in, the table of marks, and the file that is imported.

`handed_in` finds the files of a download, `roster` reads the list of the class and `matching` says
who is who; `marks_table` makes and writes the rows, `statistics` what failed how often,
`feedback_files` a file for each student; `class_marks` puts them together.
"""
