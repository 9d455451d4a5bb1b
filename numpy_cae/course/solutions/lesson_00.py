"""The solutions of lesson 00, two papers in pictures."""


def square(x):
    """y = x², elementwise.   dL/dx = 2 x · dL/dy"""
    y = x**2

    def pullback(dy):
        return 2 * x * dy

    return y, pullback
