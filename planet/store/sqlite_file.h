#pragma once
// SQLite with owners: a connection, a statement, and errors of ours.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace planet {

/// A connection. Not for use by several threads at once.
class SqliteFile {
  public:
    enum class Access {
        create,     ///< a new file; one that is there is replaced
        read,       ///< as it is now; not locked, not changed, and nobody may write it meanwhile
        recover,    ///< read and write: rolls back what a killed writer left in the journal
        in_memory,  ///< no file
    };

    static constexpr const char* in_memory_name = "store in memory";

    /// Throws Error(bad_data), naming the path. No schema is read yet.
    SqliteFile(const std::filesystem::path& path, Access access);

    void run(const char* sql);
    /// One whole number, e.g. of a pragma.
    std::int64_t number(const char* sql);
    /// The error of the last failed call as ours.
    [[noreturn]] void fail(std::string_view doing) const;

    sqlite3* get() const { return connection_.get(); }
    const std::string& where() const { return where_; }

  private:
    struct Close {
        void operator()(sqlite3* c) const;
    };
    std::string where_;
    std::unique_ptr<sqlite3, Close> connection_;
};

/// A prepared statement. Blobs and texts it returns live until its next step.
class SqliteStatement {
  public:
    SqliteStatement(SqliteFile& file, const char* sql);

    /// Parameters count from 1. Bytes and text must live until the step.
    SqliteStatement& bind(int parameter, std::int64_t value);
    SqliteStatement& bind(int parameter, double value);
    SqliteStatement& bind(int parameter, std::string_view text);
    SqliteStatement& bind(int parameter, std::span<const std::uint8_t> bytes);
    /// True: there is a row.
    bool step();
    void reset();

    /// Columns count from 0.
    std::int64_t integer(int column) const;
    double real(int column) const;
    std::string text(int column) const;
    std::span<const std::uint8_t> bytes(int column) const;

  private:
    struct Finalize {
        void operator()(sqlite3_stmt* s) const;
    };
    SqliteFile* file_;
    std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

}  // namespace planet
