"""The marks of a class: who handed what in, the table of marks, and the file that is imported.

`handed_in` finds the files of a download, `roster` reads the list of the class and says who is who,
`class_marks` writes the marks and a file of feedback for each student, and lists similar pairs.
"""
