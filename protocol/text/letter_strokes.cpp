#include "protocol/text/letter_strokes.hpp"

namespace scancast {

std::string_view letterStrokes(char32_t letter) {
    switch (letter) {
        case U'!':
            return "2622 2020";
        case U'"':
            return "1614 3634";
        case U'#':
            return "1016 3036 0242 0444";
        case U'$':
            return "453616050413334241301001 272/";
        case U'%':
            return "0046 1616 3030";
        case U'&':
            return "40050616261401103042";
        case U'\'':
            return "2625";
        case U'(':
            return "36252130";
        case U')':
            return "16252110";
        case U'*':
            return "1135 1531 0343";
        case U'+':
            return "2125 0343";
        case U',':
            return "201/";
        case U'-':
            return "1333";
        case U'.':
            return "2020";
        case U'/':
            return "0046";
        case U'0':
            return "103041453616050110 0145";
        case U'1':
            return "042620 0040";
        case U'2':
            return "05163645440040";
        case U'3':
            return "0516364544334241301001 1333";
        case U'4':
            return "30360242";
        case U'5':
            return "460603334241301001";
        case U'6':
            return "4536160501103041423303";
        case U'7':
            return "064620";
        case U'8':
            return "13040516364544334241301001021333";
        case U'9':
            return "0110304145361605041343";
        case U':':
            return "2121 2424";
        case U';':
            return "2323 201/";
        case U'<':
            return "450341";
        case U'=':
            return "0242 0444";
        case U'>':
            return "054301";
        case U'?':
            return "05163645442322 2020";
        case U'@':
            return "401001051636454232 3424223234";
        case U'A':
            return "002640 1232";
        case U'B':
            return "00063645443303 3342413000";
        case U'C':
            return "4536160501103041";
        case U'D':
            return "00062644422000";
        case U'E':
            return "46060040 0333";
        case U'F':
            return "460600 0333";
        case U'G':
            return "45361605011030414323";
        case U'H':
            return "0006 4046 0343";
        case U'I':
            return "2026";
        case U'J':
            return "4641301001";
        case U'K':
            return "0006 460340";
        case U'L':
            return "060040";
        case U'M':
            return "0006234640";
        case U'N':
            return "00064046";
        case U'O':
            return "103041453616050110";
        case U'P':
            return "00063645443303";
        case U'Q':
            return "103041453616050110 2240";
        case U'R':
            return "00063645443303 2340";
        case U'S':
            return "453616050413334241301001";
        case U'T':
            return "0646 2620";
        case U'U':
            return "060110304146";
        case U'V':
            return "062046";
        case U'W':
            return "0610243046";
        case U'X':
            return "0640 0046";
        case U'Y':
            return "062346 2320";
        case U'Z':
            return "06460040";
        case U'[':
            return "36262030";
        case U'\\':
            return "0640";
        case U']':
            return "16262010";
        case U'^':
            return "042644";
        case U'_':
            return "0/4/";
        case U'`':
            return "1625";
        case U'a':
            return "4044 4130100103143443";
        case U'b':
            return "0006 0314344341301001";
        case U'c':
            return "4334140301103041";
        case U'd':
            return "4046 4334140301103041";
        case U'e':
            return "02424334140301103041";
        case U'f':
            return "46362520 0444";
        case U'g':
            return "444/3.1.0/ 4334140301103041";
        case U'h':
            return "0006 0314344340";
        case U'i':
            return "2420 2626";
        case U'j':
            return "343/2.1. 3636";
        case U'k':
            return "0006 440240";
        case U'l':
            return "262130";
        case U'm':
            return "0004 03142320 23344340";
        case U'n':
            return "0004 0314344340";
        case U'o':
            return "103041433414030110";
        case U'p':
            return "0.04 0314344341301001";
        case U'q':
            return "4.44 4334140301103041";
        case U'r':
            return "0004 03143443";
        case U's':
            return "4414031232413000";
        case U't':
            return "26213041 0444";
        case U'u':
            return "0401103041 4440";
        case U'v':
            return "042044";
        case U'w':
            return "0410243044";
        case U'x':
            return "0440 0044";
        case U'y':
            return "0420 441.";
        case U'z':
            return "04440040";
        case U'{':
            return "36262413222030";
        case U'|':
            return "272/";
        case U'}':
            return "16262433222010";
        case U'~':
            return "03143243";
        case U'\u00b0':  // degree
            return "1526352415";
        case U'\u00b2':  // squared
            return "1636351333";
        case U'\u00b3':  // cubed
            return "1636 3633 3313 2535";
        case U'\u00b5':  // micro
            return "0.04 01103041 4440";
        case U'\u00d7':  // times
            return "0440 0044";
        default:
            return "";
    }
}

}  // namespace scancast
