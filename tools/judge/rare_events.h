// The error of a place that rare events have not hit. A pixel at the outermost tail of the filter, or under a few splats, shows no spread,
// or far too little, by accident: its estimated error is no error, and two sound methods that miss differently would be called different.
//
// Events of height h that arrive n times by chance in the mean of all replicates (Poisson) give the mean m = h E[n] and the variance of
// that mean h^2 E[n]: variance/mean = h, the height of one event in units of the mean, whatever the rate. So the neighbourhood knows what
// the place does not: h is the mean of variance/mean around it, each place weighted by its variance (what is bright without
// noise, such as a lamp seen in full, tells nothing of the height of events and must not dilute it). The place's own mean may be zero by
// accident too: the larger mean m of both sides stands for it, and its variance is at least h m.
//
// The floor is for places of few events alone. An expected number of m/h events stays away altogether with probability exp(-m/h): from
// `enoughEvents` on that is below 1e-13, less than any test here asks for, and the place's own variance is believed. So a wrong pixel or
// tile under ordinary noise is found as if there were no floor.
//
// Where rare events come on top of much ordinary light, variance/mean is far less than their height, and a place that has met a few too few
// of them looks well known. There the asymmetry of the noise speaks: events of height h have the third cumulant h^3 E[n], so that third
// over second is h, however much even light they lie on (Evidence::events, by tile). A difference d is worth |d|/h events, all of which one
// side may miss by chance with exp(-|d|/h), whatever its errors say: no p is smaller. Ordinary noise has so small an h that this never
// shows.
//
// The neighbourhood of a pixel is its tile, that of a tile the 3x3 tiles around it; where a side has no spread there at all, its whole
// picture. A method without dice has no spread anywhere and gets no floor.
#pragma once
#include "tools/judge/replicates.h"

namespace chiaro::judge {

inline constexpr double enoughEvents = 30;
// Probability that no event comes where so many of this height are expected as make up the difference.
double missedP(double difference, double height) noexcept;
// Height of one event in the mean of the picture: that of its pixels, divided by their number. Of errors as they were estimated.
double eventHeight(const Evidence&) noexcept;
// In place, both sides of one size and tile: raises the errors of tiles, and those of pixels where they are not pooled already.
void floorRareEvents(Evidence& a, Evidence& b);

} // namespace chiaro::judge
