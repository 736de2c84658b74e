# Libraries of the simulation, all from packages of Debian 12 or 13.

include(GauntletMujoco)

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(yaml-cpp REQUIRED)
find_package(fmt REQUIRED)
find_package(utf8cpp REQUIRED)  # 3.2 or 4: its package files refuse a range of versions
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(Threads REQUIRED)
find_package(nlopt_cxx REQUIRED CONFIG CONFIGS NLoptConfig.cmake)
find_package(SQLite3 REQUIRED)
find_package(SQLiteCpp REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(osmesa REQUIRED IMPORTED_TARGET osmesa)
pkg_check_modules(cairo REQUIRED IMPORTED_TARGET cairo)
pkg_check_modules(expat REQUIRED IMPORTED_TARGET expat)
pkg_check_modules(matio REQUIRED IMPORTED_TARGET matio)
pkg_check_modules(lz4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
find_package(Snappy REQUIRED CONFIG)
pkg_check_modules(xxhash REQUIRED libxxhash>=0.8)  # its header alone
pkg_check_modules(libav REQUIRED IMPORTED_TARGET libavformat libavcodec libavutil libswscale)
set(HDF5_PREFER_PARALLEL OFF)
find_package(HDF5 1.10 REQUIRED COMPONENTS CXX)
find_package(ZLIB REQUIRED)
