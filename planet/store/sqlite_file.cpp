#include "planet/store/sqlite_file.h"

#include <sqlite3.h>

#include <cctype>
#include <system_error>

#include "planet/error.h"

namespace planet {

namespace {

// A longer row than any tile is damage, not something to allocate for.
constexpr int longest_row_bytes = 1 << 20;

std::string uri_from_path(const std::filesystem::path& path, const char* query) {
    std::string uri = "file:";
    for (const char c : std::filesystem::absolute(path).string()) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte) || c == '/' || c == '.' || c == '-' || c == '_') {
            uri += c;
        } else {
            const char* digits = "0123456789ABCDEF";
            uri += {'%', digits[byte >> 4], digits[byte & 15]};
        }
    }
    return uri + query;
}

// A quota or a limit of file sizes is a failing write to SQLite.
bool lacks_space(sqlite3* connection) {
    return (sqlite3_errcode(connection) & 0xff) == SQLITE_FULL ||
           sqlite3_extended_errcode(connection) == SQLITE_IOERR_WRITE;
}

}  // namespace

void SqliteFile::Close::operator()(sqlite3* c) const {
    sqlite3_close_v2(c);
}

SqliteFile::SqliteFile(const std::filesystem::path& path, Access access)
    : where_(access == Access::in_memory ? in_memory_name : path.string()) {
    std::string uri = ":memory:";
    int flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI;
    if (access == Access::create) {
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
        std::filesystem::remove(path.string() + "-journal", ignored);
        uri = uri_from_path(path, "");
    } else if (access == Access::read) {
        uri = uri_from_path(path, "?immutable=1");
    } else if (access == Access::recover) {
        uri = uri_from_path(path, "");
    }
    if (access == Access::read)
        flags |= SQLITE_OPEN_READONLY;
    else
        flags |= SQLITE_OPEN_READWRITE;
    if (access == Access::create || access == Access::in_memory) flags |= SQLITE_OPEN_CREATE;

    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2(uri.c_str(), &opened, flags, nullptr);
    connection_.reset(opened);
    if (result != SQLITE_OK) fail("cannot be opened");
    sqlite3_limit(get(), SQLITE_LIMIT_LENGTH, longest_row_bytes);
    sqlite3_db_config(get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
}

void SqliteFile::fail(std::string_view doing) const {
    const char* reason = connection_ ? sqlite3_errmsg(get()) : "out of memory";
    if (connection_ && lacks_space(get()))
        throw Error(Fault::bad_data, where_, "the disk is full, or takes no more (" + std::string(reason) + ")");
    throw Error(Fault::bad_data, where_, std::string(doing) + " (" + reason + ")");
}

void SqliteFile::run(const char* sql) {
    if (sqlite3_exec(get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail("the store cannot be used");
}

std::int64_t SqliteFile::number(const char* sql) {
    SqliteStatement s(*this, sql);
    return s.step() ? s.integer(0) : 0;
}

void SqliteStatement::Finalize::operator()(sqlite3_stmt* s) const {
    sqlite3_finalize(s);
}

SqliteStatement::SqliteStatement(SqliteFile& file, const char* sql) : file_(&file) {
    sqlite3_stmt* prepared = nullptr;
    if (sqlite3_prepare_v3(file.get(), sql, -1, SQLITE_PREPARE_PERSISTENT, &prepared, nullptr) != SQLITE_OK)
        file.fail("the store is damaged");
    statement_.reset(prepared);
}

SqliteStatement& SqliteStatement::bind(int parameter, std::int64_t value) {
    sqlite3_bind_int64(statement_.get(), parameter, value);
    return *this;
}

SqliteStatement& SqliteStatement::bind(int parameter, double value) {
    sqlite3_bind_double(statement_.get(), parameter, value);
    return *this;
}

SqliteStatement& SqliteStatement::bind(int parameter, std::string_view text) {
    sqlite3_bind_text(statement_.get(), parameter, text.data(), static_cast<int>(text.size()), SQLITE_STATIC);
    return *this;
}

SqliteStatement& SqliteStatement::bind(int parameter, std::span<const std::uint8_t> bytes) {
    sqlite3_bind_blob(statement_.get(), parameter, bytes.data(), static_cast<int>(bytes.size()), SQLITE_STATIC);
    return *this;
}

bool SqliteStatement::step() {
    const int result = sqlite3_step(statement_.get());
    if (result == SQLITE_ROW) return true;
    if (result != SQLITE_DONE) file_->fail("the store cannot be used");
    return false;
}

void SqliteStatement::reset() {
    sqlite3_reset(statement_.get());
    sqlite3_clear_bindings(statement_.get());
}

std::int64_t SqliteStatement::integer(int column) const {
    return sqlite3_column_int64(statement_.get(), column);
}

double SqliteStatement::real(int column) const {
    return sqlite3_column_double(statement_.get(), column);
}

std::string SqliteStatement::text(int column) const {
    const auto* begin = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
    return begin ? std::string(begin, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)))
                 : std::string();
}

std::span<const std::uint8_t> SqliteStatement::bytes(int column) const {
    const auto* begin = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_.get(), column));
    return {begin, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

}  // namespace planet
