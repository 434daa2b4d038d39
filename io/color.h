// From linear Rec.709 radiance to a screen: exposure (x 2^EV), then a view of an OpenColorIO configuration. The default is io/chiaro.ocio,
// compiled into the program; its default view, "Standard" on sRGB, maps no tone (1.0 is white). Display only: no EXR passes through here.
#pragma once
#include "core/render/error.h"
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace chiaro {

class DisplayTransform {
public:
    // config: path of an OpenColorIO configuration; empty: that of $OCIO, else our own. view: "NAME" (the first display that has it) or
    // "DISPLAY/NAME", case ignored; empty: the configuration's default. Throws Error(Exit::file) for a configuration that cannot be loaded,
    // Error(Exit::usage) for an unknown view, with the list and the nearest name.
    explicit DisplayTransform(const std::string& config = {}, const std::string& view = {});
    ~DisplayTransform();

    const std::string& display() const noexcept { return display_; }
    const std::string& view() const noexcept { return view_; }
    const std::string& source() const noexcept { return source_; } // "built in" or the path
    const std::string& note() const noexcept { return note_; }     // a guess that had to be made; empty: none
    bool srgb() const noexcept;                                    // an sRGB screen is meant

    // rgb: interleaved triples, in place; afterwards encoded for the display, not clamped.
    void apply(std::span<float> rgb, double exposure) const;
    // The same as bytes: clamped to [0, 1], then rounded to nearest. What is not a number is black.
    std::vector<uint8_t> bytes(std::span<const float> rgb, double exposure) const;

    static std::vector<std::string> views(const std::string& config = {}); // "NAME (DISPLAY)"

private:
    struct Processors;
    std::unique_ptr<Processors> processors_;
    std::string display_, view_, source_, note_;
};

// The exposure in EV that brings the log-average luminance of the lit pixels to 0.18 (Reinhard et al., Photographic Tone Reproduction,
// 2002), lowered where the 99.5 % quantile of their luminance would clip; in tenths, rounded down, so that the number as printed gives the
// same picture. rgb: interleaved triples. 0 for a picture without light.
// lamps: one flag a pixel, or empty. A lamp in the picture is not lit, it shines: flagged pixels do not count (a visible lamp a hundred
// times brighter than the room would leave the room black), unless they are most of the picture.
double autoExposure(std::span<const float> rgb, std::span<const uint8_t> lamps = {});

} // namespace chiaro
