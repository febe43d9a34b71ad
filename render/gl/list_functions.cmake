# Writes OUTPUT: one line OCTAGLOBE_GL(Name) for every function glName of core OpenGL 1.0 to 4.5 that HEADER
# (GL/glcorearb.h) declares. The header lists the versions in order and the extensions behind them. The bounds-checked glGetn* are left
# out: OSMesa answers glGetnTexImage and two more with stubs that lead nowhere, or, once libEGL is loaded, with null.
function(octaglobe_list_gl_functions HEADER OUTPUT)
    file(READ ${HEADER} text)
    string(FIND "${text}" "#ifndef GL_VERSION_4_6" end)
    string(SUBSTRING "${text}" 0 ${end} text)  # an older header has no 4.6: -1 is the whole text
    string(REGEX MATCHALL "APIENTRY gl[A-Za-z0-9_]+ \\(" functions "${text}")
    list(FILTER functions EXCLUDE REGEX "APIENTRY glGetn")
    list(LENGTH functions count)
    if(count LESS 600)
        message(FATAL_ERROR "${HEADER}: ${count} core functions found, about 650 expected")
    endif()
    list(TRANSFORM functions REPLACE "APIENTRY gl([A-Za-z0-9_]+) \\(" "OCTAGLOBE_GL(\\1)\n")
    string(CONCAT text ${functions})
    file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "${text}" @ONLY)  # leaves an unchanged file alone
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${HEADER})
endfunction()
