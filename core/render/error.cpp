#include "core/render/error.h"
#include <algorithm>
#include <numeric>

namespace chiaro {
namespace {

std::size_t editDistance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0u);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t above = row[j];
            row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
            diagonal = above;
        }
    }
    return row[b.size()];
}

} // namespace

void Diagnostics::warn(std::string message) {
    const std::lock_guard lock(mutex_);
    if (std::find(warnings_.begin(), warnings_.end(), message) == warnings_.end()) warnings_.push_back(std::move(message));
}

void Diagnostics::tell(std::string subject, std::string message) {
    const std::lock_guard lock(mutex_);
    Fact fact{std::move(subject), std::move(message)};
    if (std::find(facts_.begin(), facts_.end(), fact) == facts_.end()) facts_.push_back(std::move(fact));
}

std::vector<Diagnostics::Fact> Diagnostics::facts() const {
    const std::lock_guard lock(mutex_);
    return facts_;
}

std::vector<std::string> Diagnostics::warnings() const {
    const std::lock_guard lock(mutex_);
    return warnings_;
}

std::string nearest(const std::string& word, const std::vector<std::string>& candidates) {
    std::string best;
    std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1; // farther is no likeness
    for (const std::string& c : candidates) {
        // A word that begins like the candidate is meant, however much was added or left out.
        const bool prefix = std::min(word.size(), c.size()) >= 3 && (c.starts_with(word) || word.starts_with(c));
        const std::size_t distance = prefix ? 1 : editDistance(word, c);
        if (distance < least) {
            least = distance;
            best = c;
        }
    }
    return best;
}

} // namespace chiaro
