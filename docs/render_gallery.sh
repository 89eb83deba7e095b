#!/usr/bin/env bash
# Renders the pictures of docs/methods.md, all of them, with the program itself, into docs/images/methods.
#   docs/render_gallery.sh [FOLDER OF THE scancast PROGRAM] [FOLDER OF REAL SCANS] [FOLDER FOR CLOUD FILES]
# A real scan that is missing is named, and its pictures stay as they are. Cloud files that are there already are
# taken as they are.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${1:-$root/build/release/bin}
scans=${2:-$root/../shared/data}
clouds=${3:-}
if [ -z "$clouds" ]; then
    clouds=$(mktemp -d)
    trap 'rm -rf "$clouds"' EXIT
fi
pictures=$root/docs/images/methods
mkdir -p "$pictures"
all="point square circle paraboloid cone sphere hqs disc ewa voronoi pyramid"

generated() {  # NAME SCENE POINTS
    [ -e "$clouds/$1.scan" ] && return
    "$bin/scancast" generate "$2" --points "$3" --origin 0,0,0 -o "$clouds/$1.ply" --quiet
    "$bin/scancast" ingest "$clouds/$1.ply" -o "$clouds/$1.scan" --quiet
    rm "$clouds/$1.ply"
}

real() {  # NAME FILE FLAGS…
    [ -e "$clouds/$1.scan" ] && return
    if [ ! -e "$scans/$2" ]; then
        echo "MISSING SCAN: $scans/$2 - its pictures are not rendered" >&2
        return
    fi
    "$bin/scancast" ingest "$scans/$2" -o "$clouds/$1.scan" --quiet "${@:3}"
}

picture() {  # CLOUD PICTURE FLAGS…; no larger than 60 kB
    [ -e "$clouds/$1.scan" ] || return 0
    local file=$pictures/$2.jpg light=(--shading auto)  # the method's own, whatever the cloud's look says
    [[ " ${*:3} " != *" --shading "* ]] || light=()
    for quality in 82 70 55 40 30; do
        "$bin/scancast" render "$clouds/$1.scan" -o "$file" --width 640 --height 360 --quality "$quality" "${light[@]}" "${@:3}"
        [ "$(wc -c < "$file")" -gt 60000 ] || break
    done
}

every() {  # CLOUD PICTURE FLAGS…: in every method
    for method in $all; do picture "$1" "$2-$method" --method "$method" "${@:3}"; done
}

generated statue statue 1.2M
generated sign sign 100k
generated cube cube 20k
generated bridge bridge 1M
generated torus torus 4k
generated town town 4M
generated room room 1M
real lion copc/lion_takanawa.copc.laz
real guanyin ply/guanyin-statue.ply
real autzen laz/autzen-stadium-10m.laz --orient up

# The same views in every method.
every statue statue --eye=-1.5,-3.3,2.6 --target=0.05,0,1.75 --fov 42
every sign sign --eye=-0.9,-1.3,1.0 --target=-0.1,0,0.75 --fov 36
every lion lion --eye=-0.7,0.2,0.6 --target=-2.9,3.6,-0.9 --fov 42
every guanyin guanyin --eye=0.12,1.02,0.62 --target=0.0,0.98,0 --up=0,1,0 --fov 36
every autzen autzen --eye 636850,851150,980 --target 637384,851960,430 --fov 40

# What methods' parameters do.
crease=(--eye=2.1,-2.1,1.5 --target=0.75,-0.75,0.4 --fov 40)
picture cube voronoi-flat "${crease[@]}" --method voronoi --param smooth=false
picture cube voronoi-smooth "${crease[@]}" --method voronoi
picture cube voronoi-paraboloid "${crease[@]}" --method paraboloid --shading phong
picture cube voronoi-ewa "${crease[@]}" --method ewa
for bent in true false; do
    picture torus "disc-curved-$bent" --method disc --param curved=$bent --color '#c8b890' --shading phong --light occlusion=0
done
far=(--eye=-60,-75,30 --target=15,15,4 --fov 22)
for method in circle ewa; do picture town "far-$method" --method "$method" --shading unlit --samples 1 "${far[@]}"; done
hidden=(--eye=-16,-30,5 --target=2,0,3 --fov 36)
for method in point pyramid; do picture bridge "hidden-$method" --method "$method" "${hidden[@]}"; done
picture bridge hidden-visibility --method pyramid --color visibility --samples 1 "${hidden[@]}"
picture bridge hidden-fixed --method pyramid --param hprPx=64 "${hidden[@]}"

# Light, colours, mirrors.
head=(--eye=-1.0,1.4,0.2 --target=-2.7,3.7,0.0 --fov 34)
for shading in unlit phong eyedome; do picture lion "shading-$shading" --shading "$shading" "${head[@]}"; done
roofs=(--eye=-60,-75,42 --target=5,5,2 --fov 40)
for color in rgb intensity elevation classification normal depth lod '#c8b890'; do
    shading=eyedome
    [ "$color" = rgb ] && shading=unlit
    picture town "color-${color#\#}" --color "$color" --shading "$shading" "${roofs[@]}"
done
picture statue color-curvature --color curvature --shading unlit --method ewa --eye=-1.5,-3.3,2.6 --target=0.05,0,1.75 --fov 42
mirror=(--eye=-1.7,-1.8,1.6 --target=0.5,1.5,1.2 --fov 70 --method disc --shading unlit)
picture room mirror "${mirror[@]}"
picture room mirror-off "${mirror[@]}" --mirrors false --behind-mirrors true
