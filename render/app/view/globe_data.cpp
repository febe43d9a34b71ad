#include "render/app/view/globe_data.h"

#include "planet/error.h"
#include "render/app/data_path.h"
#include "render/sky/atmosphere.h"

namespace render {

GlobeLoading::GlobeLoading(const RenderOptions& options)
    : options_(options), data_(std::async(std::launch::async, [this] { return load(); })) {}

GlobeLoading::~GlobeLoading() {
    given_up_ = true;
}

GlobeLoading::Progress GlobeLoading::progress() const {
    const std::lock_guard lock(mutex_);
    return progress_;
}

void GlobeLoading::note(std::string_view step, double part) {
    if (given_up_) throw planet::Error(planet::Fault::bad_data, "loading", "given up");
    const std::lock_guard lock(mutex_);
    progress_ = {std::string(step), part};
}

GlobeData GlobeLoading::load() {
    GlobeData data;
    const auto progress = [this](std::string_view step, double part) { note(step, part); };
    LazyEarth earth(options_.earth);
    ChecksumIndex index = user_checksum_index();
    std::shared_ptr<const planet::ElevationStore> store;
    if (options_.store)
        store = std::make_shared<const planet::ElevationStore>(
            planet::ElevationStore::open(*options_.store, planet::wgs84));
    else
        store = open_earth_store(options_.earth, earth, index, progress);
    data.surface = std::make_unique<DrawnSurface>(store, options_);
    note("pictures", 0);
    data.imagery = open_imagery(
        options_.imagery, options_.earth, index, [&] { return earth.get().heights; }, options_.thread_count(),
        progress);
    data.stars = read_stars(data_file("stars.csv"));
    data.noise = make_noise_levels();
    note("layers", 0);
    data.layers = LayerData::load(options_, true);
    index.save();
    return data;
}

}  // namespace render
