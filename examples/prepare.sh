# SPDX-License-Identifier: LGPL-2.1-or-later
# shellcheck shell=sh
# What quickstart.sh and stereo.sh begin with. They set `source`, `build` and `output` before.

# prepare PROGRAM...: installs what is missing, builds the plugin and these, and goes to the folder
# of the output.
prepare() {
  "$source/examples/install-packages.sh" build
  [ -f "$build/build.ninja" ] || meson setup "$build" "$source" --unity=on \
    -Dunity_size=8 -Dtests=false
  echo "Building; $build/quickstart.log tells how far it is."
  for program in "$@"; do
    shift
    set -- "$@" "examples/$program"
  done
  ninja -C "$build" gst/libgstcalvin.so "$@" >"$build/quickstart.log" || {
    cat "$build/quickstart.log" >&2; exit 1; }
  export GST_PLUGIN_PATH_1_0="$build/gst${GST_PLUGIN_PATH_1_0:+:$GST_PLUGIN_PATH_1_0}"
  mkdir -p "$output"
  cd "$output"
}

# fetch_pictures CAMERA FOLDER: those of one camera (left, right) of the Debian package opencv-doc,
# taken out of it without installing it.
fetch_pictures() {
  [ ! -d "$2" ] || return 0
  if [ ! -d "$output/package" ]; then
    mkdir -p "$output/package.new"
    (cd "$output/package.new" && { apt-get download -q opencv-doc || {
      apt-get update -q && apt-get download -q opencv-doc; }; })
    dpkg-deb --extract "$output"/package.new/opencv-doc_*.deb "$output/package.new"
    mv "$output/package.new" "$output/package"
  fi
  mkdir -p "$2.new"
  find "$output/package" -name "$1[0-9]*.jpg" -exec cp {} "$2.new" \;
  mv "$2.new" "$2"
}

# An argument that is a path, from where the script was started.
absolute() {
  case "$1" in /*) echo "$1" ;; *) echo "$start/$1" ;; esac
}
