#include "planet/elevation/mosaic_digest.h"

#include <algorithm>
#include <filesystem>

#include "planet/error.h"

namespace planet {

MosaicDigest::MosaicDigest(const RasterMosaic& mosaic) : buffer_(std::size_t{1} << 20) {
    const double rows = mosaic.header().height;
    for (const MosaicPart& part : mosaic.parts())
        for (const std::string& path : part.files) {
            std::error_code failed;
            if (!std::filesystem::is_regular_file(path, failed)) continue;
            files_.push_back({path, part.window.row / rows, (part.window.row + part.window.rows) / rows,
                              std::filesystem::file_size(path, failed)});
        }
    std::sort(files_.begin(), files_.end(), [](const File& a, const File& b) { return a.path < b.path; });
    files_.erase(std::unique(files_.begin(), files_.end(), [](auto& a, auto& b) { return a.path == b.path; }),
                 files_.end());
}

void MosaicDigest::advance(double fraction) {
    for (File& file : files_) {
        const double part = std::clamp((fraction - file.first) / (file.last - file.first), 0.0, 1.0);
        hash(file, part < 1 ? static_cast<std::uintmax_t>(part * static_cast<double>(file.bytes)) : file.bytes);
    }
}

void MosaicDigest::hash(File& file, std::uintmax_t until) {
    if (!file.digest.empty()) return;
    while (file.done < until) {
        if (!file.stream.is_open()) file.stream.open(file.path, std::ios::binary);
        const auto wanted = std::min<std::uintmax_t>(buffer_.size(), until - file.done);
        if (!file.stream.read(buffer_.data(), static_cast<std::streamsize>(wanted)))
            throw Error(Fault::bad_data, file.path, "cannot be read at byte " + std::to_string(file.done));
        file.sum.add(buffer_.data(), wanted);
        file.done += wanted;
    }
    if (file.done < file.bytes) return;
    file.digest = file.sum.hex();
    file.stream = {};
}

std::string MosaicDigest::finish() {
    advance(1);
    if (files_.size() == 1) return files_[0].digest;
    if (files_.empty()) return {};
    Sha256 all;
    for (const File& file : files_) all.add(file.digest.data(), file.digest.size());
    return all.hex();
}

}  // namespace planet
