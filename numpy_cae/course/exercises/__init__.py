"""The exercises of the lessons as data, a module each; `numpy_cae.course.catalogue` lists them."""
