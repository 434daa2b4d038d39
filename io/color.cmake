# The OpenColorIO configuration becomes a string of the program: no file has to be found at run time.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/chiaro.ocio)
file(READ ${CMAKE_CURRENT_LIST_DIR}/chiaro.ocio CHIARO_OCIO)
configure_file(${CMAKE_CURRENT_LIST_DIR}/color_config.cpp.in ${CMAKE_BINARY_DIR}/io/color_config.cpp @ONLY)
target_sources(chiaro_io PRIVATE ${CMAKE_BINARY_DIR}/io/color_config.cpp)
