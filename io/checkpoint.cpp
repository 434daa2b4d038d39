#include "io/checkpoint.h"
#include <charconv>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace chiaro {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
constexpr FileKind kind{"chiaro checkpoint 1", "checkpoint of chiaro", "Render it again"};
// Lines of the heading that are not part of the key.
constexpr const char *samplesLine = ".samples", *evenLine = ".even", *secondsLine = ".seconds", *restLine = ".rest";

std::string oneLine(const Json& j) { return j.dump(-1, ' ', true, Json::error_handler_t::replace); }

FileKey headingOf(const CheckpointHead& h, const Film& film) {
    FileKey all = h.key;
    all.emplace_back(samplesLine, fmt::format("{}:{}", film.begin(), film.done()));
    all.emplace_back(evenLine, film.even() ? "1" : "0");
    all.emplace_back(secondsLine, fmt::format("{}", h.seconds));
    all.emplace_back(
        restLine,
        oneLine({{"options", h.options}, {"command", h.command}, {"again", h.again}, {"stem", h.stem}, {"warnings", h.warnings}}));
    return all;
}

template <class T> bool number(std::string_view text, T& to) {
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), to);
    return failed == std::errc() && end == text.data() + text.size();
}

CheckpointHead headOf(const fs::path& file, KeyedEntry entry) {
    CheckpointHead h;
    const std::string samples = valueOf(entry.key, samplesLine);
    const std::size_t colon = std::min(samples.find(':'), samples.size());
    bool sound = number(samples.substr(0, colon), h.begin) && number(samples.substr(std::min(colon + 1, samples.size())), h.done) &&
                 number(valueOf(entry.key, secondsLine), h.seconds);
    h.even = valueOf(entry.key, evenLine) == "1";
    const Json rest = Json::parse(valueOf(entry.key, restLine), nullptr, false);
    try {
        rest.at("options").get_to(h.options);
        rest.at("command").get_to(h.command);
        rest.at("again").get_to(h.again);
        rest.at("stem").get_to(h.stem);
        rest.at("warnings").get_to(h.warnings);
    } catch (const Json::exception&) { sound = false; }
    if (!sound) refuseFile(file, kind, "its heading is damaged");
    for (const auto& [name, value] : entry.key)
        if (!name.starts_with('.')) h.key.emplace_back(name, value);
    h.entry = std::move(entry);
    return h;
}

void putMetadata(Writer& to, const Metadata& m) {
    to.value(uint32_t(m.size()));
    for (const auto& [name, value] : m) {
        to.text(name);
        to.value(uint8_t(value.index()));
        if (const auto* text = std::get_if<std::string>(&value)) to.text(*text);
        if (const auto* whole = std::get_if<int>(&value)) to.value(*whole);
        if (const auto* real = std::get_if<double>(&value)) to.value(*real);
    }
}
Metadata getMetadata(Reader& from) {
    Metadata m;
    const auto count = from.value<uint32_t>();
    for (uint32_t i = 0; i < count; ++i) {
        std::string name = from.text();
        const auto type = from.value<uint8_t>();
        if (type == 0)
            m.emplace_back(std::move(name), from.text());
        else if (type == 1)
            m.emplace_back(std::move(name), from.value<int>());
        else
            m.emplace_back(std::move(name), from.value<double>());
    }
    return m;
}

} // namespace

CheckpointHead readCheckpointHead(const fs::path& file) {
    std::vector<KeyedEntry> all = readKeyed(file, kind);
    if (all.size() > 1) refuseFile(file, kind, "holds more than one checkpoint");
    return headOf(file, std::move(all[0]));
}

Checkpoint readCheckpoint(const fs::path& file, std::size_t memory) {
    Checkpoint c;
    static_cast<CheckpointHead&>(c) = readCheckpointHead(file);
    loadKeyed(file, kind, c.entry, [&](Reader& from) {
        c.recipe = getMetadata(from);
        c.depth = from.array<float>();
        c.lamp = from.array<uint8_t>();
        c.state = from.text();
        c.film = Film::load(from, memory);
    });
    const Film& film = *c.film;
    const uint64_t area = film.layout().crop.area();
    if (c.depth.size() != area || c.lamp.size() != area || film.begin() != c.begin || film.done() != c.done || film.even() != c.even)
        refuseFile(file, kind, "its heading is not that of its film; it is damaged");
    return c;
}

void writeCheckpoint(const fs::path& file, const Checkpoint& c, const Film& film, const std::string& state) {
    writeKeyed(file, kind, headingOf(c, film), [&](Writer& to) {
        putMetadata(to, c.recipe);
        to.array(c.depth);
        to.array(c.lamp);
        to.text(state);
        film.save(to);
    });
}

std::string stateOf(const Integrator& integrator) {
    std::ostringstream out;
    Writer writer(out);
    integrator.save(writer);
    return std::move(out).str();
}

void loadState(const fs::path& file, const std::string& state, const Job& job, Integrator& integrator) {
    std::istringstream in(state);
    Reader reader(in, file.string(), state.size());
    integrator.load(job, reader);
    if (reader.left() > 0) reader.refuse("holds more than its integrator remembers; render it again");
}

} // namespace chiaro
