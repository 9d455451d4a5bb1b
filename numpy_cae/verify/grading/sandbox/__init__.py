"""A student's file is graded in processes of its own: what is guarded stands in docs/verify.md."""
