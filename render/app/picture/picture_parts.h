#pragma once
// How a picture that is too large to be drawn at once is divided.

#include <vector>

#include "render/app/values.h"
#include "render/picture/camera.h"

namespace render {

PicturePart grown(const PicturePart& part, int margin);

/// Pixels around a part that are drawn and not kept: a star whose middle is outside of what is drawn is not drawn, but its
/// light would reach inside.
inline constexpr int least_part_margin = 8;

/// The parts of a picture, in rows from the top, and in smaller pieces where one is too much at once. They are the same
/// whatever of the picture is wanted, which is why a crop has the pixels of the whole.
class PictureParts {
  public:
    struct Limits {
        int side;    ///< pixels: a picture no larger is one part; others have parts that are with the least margin
        int margin;  ///< pixels, at least least_part_margin
    };
    PictureParts(const Camera& camera, const PictureCrop& wanted, const Limits& limits);

    /// Ever the next one is the last.
    bool empty() const { return rest_.empty(); }
    PicturePart take();
    bool can_be_split(const PicturePart& part) const;
    /// Its quarters come next.
    void put_back_split(const PicturePart& part);

    PicturePart drawn(const PicturePart& part) const { return single_ ? part : grown(part, margin_); }
    PicturePart kept(const PicturePart& part) const;
    /// The rows of what is wanted that come with a part.
    PicturePart band(const PicturePart& part) const;

  private:
    void add(const PicturePart& part);

    PicturePart wanted_;
    bool single_;
    int margin_;
    int width_, height_;  ///< of parts
    std::vector<PicturePart> rest_;
};

}  // namespace render
