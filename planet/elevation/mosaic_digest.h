#pragma once
// The checksum of a mosaic's files, made while its samples are read.

#include <fstream>
#include <string>
#include <vector>

#include "planet/elevation/raster_mosaic.h"
#include "planet/elevation/sha256.h"

namespace planet {

/// Gives what checksum_of_files() gives, a piece at a time: whoever reads the mosaic from its first row to its last and
/// says how far he is has the bytes hashed that he has just read, which the system still holds then.
class MosaicDigest {
  public:
    explicit MosaicDigest(const RasterMosaic& mosaic);
    /// @param fraction of the rows that are done, 0..1, never less than before
    void advance(double fraction);
    /// Does what is left. Empty if the mosaic is made of no files, e.g. inside an archive. Once.
    std::string finish();

  private:
    struct File {
        std::string path;
        double first, last;  // rows it holds, as fractions of the mosaic's
        std::uintmax_t bytes, done = 0;
        std::ifstream stream{};
        Sha256 sum{};
        std::string digest{};
    };
    void hash(File& file, std::uintmax_t until);

    std::vector<File> files_;  // by path
    std::vector<char> buffer_;
};

}  // namespace planet
