# cmake -DSHADERS=a.glsl,b.glsl -DFOLDER=dir -DOUTPUT=file.cpp -P embed_shaders.cmake
# Writes a C++ file that holds the shaders as raw string literals, for render::shader_source. A literal may not be longer
# than 65536 characters by the standard's least limit, and none of ours is.
string(REPLACE "," ";" SHADERS "${SHADERS}")
set(text "// Generated from render/shaders: do not edit.\n#include \"render/gl/shader_source.h\"\n\n")
string(APPEND text "namespace render {\n\nstd::span<const ShaderSource> shader_sources() {\n")
string(APPEND text "    static constexpr ShaderSource sources[] = {\n")
foreach(name IN LISTS SHADERS)
    file(READ "${FOLDER}/${name}" source)
    string(FIND "${source}" ")GLSL\"" clash)
    if(NOT clash EQUAL -1)
        message(FATAL_ERROR "${name}: contains the end mark of a raw string literal")
    endif()
    string(APPEND text "        {\"${name}\", R\"GLSL(${source})GLSL\"},\n")
endforeach()
string(APPEND text "    };\n    return sources;\n}\n\n}  // namespace render\n")
file(WRITE "${OUTPUT}" "${text}")
