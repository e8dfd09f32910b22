"""How kernels become machine code, and where it is kept: everything that depends on Numba's internals."""
