# Checks that the C++ wrapper calls every function of the C header, and has a type for every struct of settings.
#
#   cmake -DSOURCE=<root of the source tree> -P wrapper_is_complete.cmake
file(GLOB parts "${SOURCE}/include/luxfer/*.h")
set(header "")
foreach(part IN LISTS parts)
  file(READ "${part}" text)
  string(APPEND header "${text}")
endforeach()
file(GLOB_RECURSE files "${SOURCE}/bindings/cpp/*.hpp")
set(wrapper "")
foreach(file IN LISTS files)
  file(READ "${file}" text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}") # Names in comments are no calls.
  string(APPEND wrapper "${text}")
endforeach()

string(REGEX REPLACE "/\\*([^*]|\\*+[^*/])*\\*+/" "" header "${header}")
string(REGEX REPLACE "static inline [^}]*}" "" header "${header}")
# The wrapper need not call functions that are to go.
string(REGEX REPLACE "LUXFER_DEPRECATED\\(\"[^;]*;" "" header "${header}")
string(REGEX MATCHALL "luxfer_[a-z0-9_]+\\(" functions "${header}")
list(TRANSFORM functions REPLACE "\\(" "")
list(REMOVE_DUPLICATES functions)
list(LENGTH functions count)
string(REGEX MATCHALL "LUXFER_STRUCT_[A-Z_]+" settings "${header}")
if(count LESS 100)
  message(FATAL_ERROR "found only ${count} functions in include/luxfer.h: does this script still know its form?")
endif()

set(missing "")
foreach(function IN LISTS functions settings)
  if(NOT wrapper MATCHES "[^A-Za-z0-9_]${function}[^A-Za-z0-9_]")
    string(APPEND missing "\n  ${function}")
  endif()
endforeach()
if(missing)
  message(FATAL_ERROR "the C++ wrapper lacks these functions and settings of include/luxfer.h:${missing}\n"
    "Add to bindings/cpp/luxfer, in the class of the handle, a method that calls each:\n"
    "  Result<> set_thing(const Image &thing) const { return call(luxfer_x_set_thing, thing.get()); }\n"
    "  Result<Image> image(luxfer_x_image which) const { return make<Image>(luxfer_x_get_image, which); }\n"
    "  Result<luxfer_x_report> report() const { return value<luxfer_x_report>(luxfer_x_get_report); }\n"
    "and of each struct of settings a type: using XParams = Params<luxfer_x_params, LUXFER_STRUCT_X_PARAMS>;")
endif()
message(STATUS "all ${count} functions of include/luxfer.h are called by the C++ wrapper")
