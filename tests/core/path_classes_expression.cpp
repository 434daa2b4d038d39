// Light-path expressions: what is read, what is refused with which words, and which paths one holds and another does not.
#include "core/render/error.h"
#include "core/render/path_expression_dfa.h"
#include <doctest/doctest.h>

using namespace chiaro;

TEST_SUITE("path_expression") {
    TEST_CASE("errors name the place and the fix") {
        const struct {
            std::string text, message;
        } table[] = {
            {"L D (E", "missing ) at 7; close the ( at 5"},
            {"L D E)", "unmatched ) at 6; remove it or open it with ("},
            {"", "empty expression at 1; write a path such as L D E; ? makes a part optional"},
            {"  ", "empty expression at 3; write a path such as L D E; ? makes a part optional"},
            {"L (D|) E", "empty alternative at 6; write a path such as L D E; ? makes a part optional"},
            {"L () E", "empty alternative at 4; write a path such as L D E; ? makes a part optional"},
            {"L E |", "empty alternative at 6; write a path such as L D E; ? makes a part optional"},
            {"L X E", "unknown letter X at 3; write L La Ld Le, D G S . with R or T behind, E, ? * + {n,m} | ( )"},
            {"L d E", ""}, // Ld E: white space means nothing
            {"L Dd E", "unknown letter d at 4; did you mean D?"},
            {"L R E", "lone R at 3; write it behind D, G, S or . as in SR"},
            {"L D\xc3\xa9 E", "unknown character at 4; write L La Ld Le, D G S . with R or T behind, E, ? * + {n,m} | ( )"},
            {"* L E", "nothing before * at 1; write what it repeats"},
            {"L |? E", "nothing before ? at 4; write what it repeats"},
            {"D E", "path without a light at 1; begin with L, La, Ld or Le"},
            {"L? D E", "path without a light at 4; begin with L, La, Ld or Le"},
            {"E", "path without a light at 1; begin with L, La, Ld or Le"},
            {"L D L E", "light inside a path at 5; a light stands only at the beginning"},
            {"L+ E", "light inside a path at 1; a light stands only at the beginning"},
            {"L D", "path does not reach the eye at 4; end every alternative with E"},
            {"L D E | L S ", "path does not reach the eye at 12; end every alternative with E"},
            {"L D | L S E", "path does not reach the eye at 4; end every alternative with E"},
            {"L D E?", "path does not reach the eye at 7; end every alternative with E"},
            {"L D E D", "something follows the eye at 7; end the path with E"},
            {"L D E+", "something follows the eye at 5; end the path with E"},
            {"L D{2 E", "missing } at 7; close the { at 4"},
            {"L D{ E", "missing number at 6; write {n}, {n,m} or {n,} at 4"},
            {"L D{3,2} E", "repetition counts down at 4; write the smaller number first"},
            {"L (.{100}){100} E",
             "repetitions write out to more than 2000 letters at 1; use * or +, or limit the length of paths with --max-depth"},
            {"L ((((.{99}){99}){99}){99}){99} E",
             "repetitions write out to more than 2000 letters at 1; use * or +, or limit the length of paths with --max-depth"},
            {"L D{99999999999} E",
             "repetitions write out to more than 2000 letters at 1; use * or +, or limit the length of paths with --max-depth"},
            {std::string(5000, '('), "too many nested ( at 102; write it flatter"},
            {"L D" + std::string(5000, '*') + " E", "too many repetition signs in a row at 105; one is enough"},
        };
        for (const auto& row : table) {
            CAPTURE(row.text);
            std::string message;
            try {
                PathExpression::parse(row.text, "--paths");
            } catch (const Error& e) {
                CHECK(e.code == Exit::usage);
                message = e.what();
            }
            const std::string shown = row.text.size() > 200 ? row.text.substr(0, 200) + "..." : row.text;
            CHECK(message == (row.message.empty() ? "" : "--paths \"" + shown + "\": " + row.message));
        }
    }

    TEST_CASE("white space means nothing") {
        for (const char* text : {"LD*(S|GT)+E", " L a\tD R ? { 1 , 2 } \n E ", "L D { 0 } E", "L.T{2,}E"})
            CHECK_NOTHROW(PathExpression::parse(text));
        CHECK(!firstMissing("L a D R { 1 , 2 } E", "LaDR{1,2}E"));
        CHECK(!firstMissing("LaDR{1,2}E", "L a D R { 1 , 2 } E"));
    }

    TEST_CASE("the shortest path that is missing") {
        using Path = std::optional<std::string>;
        CHECK(firstMissing("L .* E", "L (D|G|S)* E") == Path());
        CHECK(firstMissing("", "L (D|G|S)* E") == Path());
        CHECK(firstMissing("L .* E", "") == Path("L E"));
        CHECK(firstMissing("L D* E", "L D? S* E") == Path("L D D E"));
        CHECK(firstMissing("L .* E", "L (D|G)? S* E") == Path("L D D E"));
        CHECK(firstMissing("L D? E", "La .* E | Le .* E | Ld E") == Path("Ld D E"));
        CHECK(firstMissing("L .* E", "L (D|G|SR)* E") == Path("L ST E"));
        CHECK(firstMissing("L S{2,5} E", "L S{2,4} E") == Path("L S S S S S E"));
        CHECK(firstMissing("L D{1,3} E", "L D+ E") == Path());
        CHECK(firstMissing("L (D|S)* E", "L D* (S D*)* E") == Path());
    }

    TEST_CASE("what a scene holds limits what can be missing") {
        using Path = std::optional<std::string>;
        const LetterSet lamp = letter(LightKind::delta), matt = letter(Event::DR), glass = letter(Event::ST) | letter(Event::SR);
        const std::string missed = "Ld S+ (D|G) .* E";
        CHECK(firstCommon("", missed) == Path("Ld S D E"));
        CHECK(firstCommon("L .* E", missed, {LetterSet(lamp | matt | glass)}) == Path("Ld S D E"));
        CHECK(firstCommon("L .* E", missed, {LetterSet(lamp | matt | letter(Event::ST))}) == Path("Ld S D E"));
        CHECK(firstCommon("L .* E", missed, {LetterSet(lamp | matt)}) == Path());
        CHECK(firstCommon("L .* E", missed, {LetterSet(letter(LightKind::area) | matt | glass)}) == Path());
        CHECK(firstCommon("L .* E", missed, {LetterSet(anyLight | anyEvent), 1}) == Path());
        CHECK(firstCommon("L D* E", missed) == Path());
        CHECK(firstCommon("L S* D E", "") == Path());
        CHECK(firstCommon("", "L (D|G) S* E", "Ld (D|G) S* E") == Path("La D E"));
        CHECK(firstCommon("Ld .* E", "L (D|G) S* E", "Ld D S* E") == Path("Ld G E"));
        CHECK(firstCommon("L D E", "L (D|G) S* E", "L D .* E") == Path());
        CHECK(firstMissing("L .* E", "L D* E", {LetterSet(lamp | matt)}) == Path());
        CHECK(firstMissing("L .* E", "L D* E", {LetterSet(lamp | matt | letter(Event::GT)), 1}) == Path("Ld G E"));
    }
} // TEST_SUITE
