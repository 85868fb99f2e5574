// silt - BSD-3-Clause, see LICENSE
// Empty: a target with nothing but a precompiled header, for others to reuse, needs a file.
