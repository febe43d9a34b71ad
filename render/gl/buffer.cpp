#include "render/gl/buffer.h"

#include <algorithm>
#include <string>

#include "render/gl/checks.h"

namespace render {

Buffer::Buffer(std::size_t bytes, GLbitfield flags) : bytes_(bytes) {
    allocate(nullptr, flags);
}

Buffer::Buffer(std::span<const std::byte> contents, GLbitfield flags) : bytes_(contents.size()) {
    allocate(contents.empty() ? nullptr : contents.data(), flags);
}

void Buffer::allocate(const void* contents, GLbitfield flags) {
    GLuint name = 0;
    gl().CreateBuffers(1, &name);
    handle_ = Handle<BufferKind>(name);
    gl().NamedBufferStorage(name, static_cast<GLsizeiptr>(std::max<std::size_t>(bytes_, 1)), contents, flags);
    require_gl("a buffer of " + std::to_string(bytes_) + " bytes");
}

void Buffer::upload(std::span<const std::byte> contents, std::size_t offset) {
    assert(offset <= bytes_ && contents.size() <= bytes_ - offset);
    if (contents.empty()) return;
    gl().NamedBufferSubData(name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(contents.size()),
                            contents.data());
    check_gl("Buffer::upload");
}

void Buffer::download_bytes(std::span<std::byte> bytes, std::size_t offset) const {
    assert(offset <= bytes_ && bytes.size() <= bytes_ - offset);
    if (bytes.empty()) return;
    gl().GetNamedBufferSubData(name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes.size()),
                               bytes.data());
    check_gl("Buffer::download");
}

VertexArray VertexArray::create() {
    GLuint name = 0;
    gl().CreateVertexArrays(1, &name);
    VertexArray array;
    array.handle_ = Handle<VertexArrayKind>(name);
    return array;
}

void VertexArray::set_vertices(GLuint binding, const Buffer& buffer, GLsizei stride,
                               std::span<const Attribute> attributes, GLuint divisor) {
    rebind(binding, buffer, 0, stride);
    gl().VertexArrayBindingDivisor(name(), binding, divisor);
    for (const Attribute& a : attributes) {
        if (a.conversion == Attribute::Conversion::integer) {
            gl().VertexArrayAttribIFormat(name(), a.location, a.components, a.type, a.offset);
        } else {
            const GLboolean normalized = a.conversion == Attribute::Conversion::normalized ? GL_TRUE : GL_FALSE;
            gl().VertexArrayAttribFormat(name(), a.location, a.components, a.type, normalized, a.offset);
        }
        gl().VertexArrayAttribBinding(name(), a.location, binding);
        gl().EnableVertexArrayAttrib(name(), a.location);
    }
    check_gl("VertexArray::set_vertices");
}

void VertexArray::rebind(GLuint binding, const Buffer& buffer, GLintptr offset, GLsizei stride) {
    gl().VertexArrayVertexBuffer(name(), binding, buffer.name(), offset, stride);
}

void VertexArray::set_indices(const Buffer& buffer) {
    gl().VertexArrayElementBuffer(name(), buffer.name());
}

}  // namespace render
