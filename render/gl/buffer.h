#pragma once
// Buffers and vertex arrays, by direct state access: nothing is bound to be changed.

#include <cstddef>
#include <cstring>
#include <ranges>
#include <span>
#include <type_traits>
#include <vector>

#include "render/gl/handle.h"

namespace render {

/// The bytes of an array of plain values: bytes_of(vector), bytes_of(span).
template <std::ranges::contiguous_range Range>
std::span<const std::byte> bytes_of(const Range& range) {
    static_assert(std::is_trivially_copyable_v<std::ranges::range_value_t<Range>>);
    return std::as_bytes(std::span(std::ranges::data(range), std::ranges::size(range)));
}

/// A buffer of immutable size. Size 0 is held as one unused byte, so that it can be bound.
class Buffer {
  public:
    Buffer() = default;
    /// Without contents: they are undefined until upload() or the GPU writes them.
    /// @param flags of glNamedBufferStorage; GL_DYNAMIC_STORAGE_BIT allows upload()
    /// Throws planet::Error (no_graphics) if the driver has no memory for it.
    explicit Buffer(std::size_t bytes, GLbitfield flags = GL_DYNAMIC_STORAGE_BIT);
    /// With the given contents, which upload() can change only if `flags` says so.
    explicit Buffer(std::span<const std::byte> contents, GLbitfield flags = 0);

    GLuint name() const noexcept { return handle_.name(); }
    std::size_t size() const noexcept { return bytes_; }
    explicit operator bool() const noexcept { return static_cast<bool>(handle_); }

    /// Replaces bytes from `offset` on.
    void upload(std::span<const std::byte> contents, std::size_t offset = 0);
    /// Copies the contents back. Waits for the GPU.
    template <class Value>
    std::vector<Value> download(std::size_t count, std::size_t offset = 0) const {
        static_assert(std::is_trivially_copyable_v<Value>);
        std::vector<Value> values(count);
        download_bytes(std::as_writable_bytes(std::span(values)), offset);
        return values;
    }
    /// Binds it to an indexed target: GL_UNIFORM_BUFFER, GL_SHADER_STORAGE_BUFFER, GL_TRANSFORM_FEEDBACK_BUFFER.
    void bind_base(GLenum target, GLuint index) const { gl().BindBufferBase(target, index, name()); }
    /// Binds it to a target that has no index: GL_DRAW_INDIRECT_BUFFER and the like.
    void bind(GLenum target) const { gl().BindBuffer(target, name()); }

  private:
    void allocate(const void* contents, GLbitfield flags);
    void download_bytes(std::span<std::byte> bytes, std::size_t offset) const;

    Handle<BufferKind> handle_;
    std::size_t bytes_ = 0;
};

/// How a shader's attribute is read from a vertex.
struct Attribute {
    enum class Conversion {
        to_float,    ///< any type, converted by value
        normalized,  ///< integers to [0, 1] or [-1, 1]
        integer,     ///< integers as they are (int, ivec, uint, uvec in the shader)
    };
    GLuint location = 0;  ///< layout(location = ...) of the vertex shader
    GLint components = 1;
    GLenum type = GL_FLOAT;
    GLuint offset = 0;  ///< bytes from the start of the vertex
    Conversion conversion = Conversion::to_float;
};

class VertexArray {
  public:
    /// A vertex array without attributes, as a shader needs that makes its vertices from gl_VertexID.
    static VertexArray create();

    GLuint name() const noexcept { return handle_.name(); }
    explicit operator bool() const noexcept { return static_cast<bool>(handle_); }

    /// Reads the attributes from `buffer`, which must outlive its use, one vertex every `stride` bytes.
    /// @param binding one number for each buffer, 0..15
    /// @param divisor 0: a value for each vertex; n: a value for each n instances
    void set_vertices(GLuint binding, const Buffer& buffer, GLsizei stride, std::span<const Attribute> attributes,
                      GLuint divisor = 0);
    /// Changes the buffer of a binding, keeping its attributes.
    void rebind(GLuint binding, const Buffer& buffer, GLintptr offset, GLsizei stride);
    void set_indices(const Buffer& buffer);
    void bind() const { gl().BindVertexArray(name()); }

  private:
    Handle<VertexArrayKind> handle_;
};

}  // namespace render
