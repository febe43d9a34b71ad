#include "planet/elevation/raster_writer.h"

#include <unistd.h>

#include "planet/elevation/module.h"
#include "planet/error.h"

namespace planet {
namespace {

namespace fs = std::filesystem;

const RasterSinkDriver& driver() {
    using Factory = const RasterSinkDriver* (*)();
    static const RasterSinkDriver* const found = reinterpret_cast<Factory>(
        module_symbol("octaglobe_gdal", "octaglobe_gdal_sinks_1", "writing elevation files"))();
    return *found;
}

bool is_tiff(const fs::path& path) {
    std::string ending = path.extension().string();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
    return ending == ".tif" || ending == ".tiff";
}

}  // namespace

RasterWriter::RasterWriter(const std::string& path, const RasterHeader& like, const MakeFile& make_file)
    : shown_as_(path) {
    if (!is_tiff(path)) throw Error(Fault::bad_usage, path, "is not a raster format that is written", ".tif");
    std::error_code failed;
    file_ = fs::weakly_canonical(fs::absolute(path), failed);  // a link stays one
    if (failed) file_ = path;
    const auto status = fs::status(file_, failed);
    if (fs::exists(status) && !fs::is_regular_file(status))
        throw Error(Fault::bad_usage, path, "is there and is not a file", "the name of a file");
    if (!fs::is_directory(file_.parent_path(), failed) || access(file_.parent_path().c_str(), W_OK) != 0)
        throw Error(Fault::bad_usage, path, "cannot be written: no such folder, or no right to write in it",
                    "a file in a folder that can be written to");
    const fs::path temporary =
        file_.parent_path() / file_.filename().concat("." + std::to_string(getpid()) + ".part.tif");
    temporary_ = temporary;
    const RasterSinkDriver& sinks = driver();
    const auto make = [&] { sink_ = sinks.create(temporary.string(), path, like); };
    if (make_file)
        made_ = make_file(temporary, make);
    else
        make();
}

RasterWriter::~RasterWriter() {
    sink_.reset();
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void RasterWriter::write(const SampleWindow& window, std::span<const float> samples) {
    sink_->write(window, samples);
}

void RasterWriter::finish() {
    sink_->close();
    sink_.reset();
    std::error_code failed;
    fs::rename(temporary_, file_, failed);
    if (failed) throw Error(Fault::bad_usage, shown_as_, "cannot be written: " + failed.message());
    temporary_.clear();
    made_.reset();
}

}  // namespace planet
