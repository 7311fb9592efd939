#!/bin/sh
# Draws held_edges.svg: sh docs/held_edges.sh > docs/held_edges.svg
# A plate 0 ≤ x ≤ 1, |y| ≤ 0.3 that bends about its welded edge x = 0, w = A x² + curl; across it curls by
# −ν A (y² − mean), which a rigid edge holds back over the width of the plate.
awk '
function w(x, y, rigid,   c) {
    c = -0.3 * 1.6 * (y * y - 0.03)
    if (rigid) c *= 1 - exp(-x / 0.3) * (1 + x / 0.3)
    return 0.4 * x * x + c
}
function at(x, y, z) { return sprintf("%.1f,%.1f", left + 240 * x + 120 * y, 190 - 150 * y - 260 * z) }
function line(points, colour, width) {
    printf "<polyline points=\"%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"%s\"/>\n", points, colour, width
}
function text(x, y, words) {
    printf "<text x=\"%d\" y=\"%d\" font-family=\"sans-serif\" font-size=\"12\">%s</text>\n", x, y, words
}
function plate(rigid,   i, k, p) {
    for (i = 0; i <= 8; i++) {
        p = ""
        for (k = -12; k <= 12; k++) p = p " " at(i / 8, k / 40, w(i / 8, k / 40, rigid))
        line(p, "#888", 1)
    }
    for (k = -3; k <= 3; k++) {
        p = ""
        for (i = 0; i <= 24; i++) p = p " " at(i / 24, k / 10, w(i / 24, k / 10, rigid))
        line(p, "#888", 1)
    }
    line(at(0, -0.36, 0) " " at(0, 0.36, 0), "#06c", 1)
    p = ""
    for (k = -12; k <= 12; k++) p = p " " at(0, k / 40, w(0, k / 40, rigid))
    line(p, "#c30", 3)
}
BEGIN {
    print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 760 290\" width=\"760\" height=\"290\">"
    print "<rect width=\"760\" height=\"290\" fill=\"white\"/>"
    left = 70; plate(1); text(60, 270, "rigid: all nodes of the edge (red) follow the joint")
    left = 440; plate(0); text(430, 270, "mean: their average (blue) does, the edge curls")
    print "</svg>"
}'
