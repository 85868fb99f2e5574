# Toolchain file: builds for 64-bit ARM (NEON) on another machine and runs the tests in an emulator.
# Debian: apt-get install g++-aarch64-linux-gnu qemu-user; its compiler finds the headers of xsimd
# and doctest in /usr/include by itself.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L /usr/aarch64-linux-gnu)
