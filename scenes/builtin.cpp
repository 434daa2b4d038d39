#include "scenes/builtin.h"
#include "scenes/scenes.h"
#include <algorithm>
#include <array>

namespace chiaro {

std::span<const BuiltinScene> builtinScenes() {
    static constexpr std::array list = {
        BuiltinScene{"@cornell", "the Cornell box as measured: diffuse walls, two blocks, one lamp", makeCornell, 512, 512, 256},
        BuiltinScene{"@cornell-spheres", "the same room with a mirror ball and a glass ball", makeCornellSpheres, 512, 512, 512},
        BuiltinScene{"@veach-mis", "four glossy plates under four lamps of equal power, after Veach and Guibas", makeVeachMis, 768, 512,
                     128},
        BuiltinScene{"@caustic", "a glass ball that focuses a small lamp on the floor", makeCaustic, 768, 512, 1024},
        BuiltinScene{"@furnace", "a closed glowing sphere in which every pixel is exactly 2", makeFurnace, 128, 128, 64},
        BuiltinScene{"@playground", "checks, balls of mirror, glass and gold, a tumbling cube: the classical effects", makePlayground, 768,
                     480, 256, animatePlayground},
        BuiltinScene{"@gallery", "a sheet of balls: every kind of material, from smooth to rough, from weak to strong", makeGallery, 576,
                     768, 256},
    };
    return list;
}

const BuiltinScene* findBuiltin(std::string_view name) {
    const auto list = builtinScenes();
    const auto found = std::ranges::find(list, name, &BuiltinScene::name);
    return found == list.end() ? nullptr : &*found;
}

} // namespace chiaro
