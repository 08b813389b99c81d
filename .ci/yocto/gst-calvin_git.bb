# SPDX-License-Identifier: LGPL-2.1-or-later
# Yocto: a recipe for small devices, with the elements alone. The class meson writes the cross file
# from the machine's settings, so that none is kept here; outside of Yocto a cross file is
# tests/builds/aarch64.ini, with the folder of the target's libraries.
#
# Tried: the options below, natively (tests/builds/run.sh nofeatures), and the cross file with
# Debian's compiler (tests/builds/run.sh aarch64). Not tried: bitbake itself. The names of the
# recipes in DEPENDS are those of the layers openembedded-core and meta-oe; tl-expected and highway
# may want a recipe of their own, of one header and of one library.
SUMMARY = "GStreamer elements that calibrate and undistort cameras"
LICENSE = "LGPL-2.1-or-later"
LIC_FILES_CHKSUM = "file://COPYING;md5=4fbd65380cdd255951079008b364516c"

# Where this tree is.
CALVIN_URI ?= "git:///path/to/gst-calvin;protocol=file;branch=main"
SRC_URI = "${CALVIN_URI}"
SRCREV = "${AUTOREV}"
PV = "0.1.0+git"
S = "${WORKDIR}/git"

DEPENDS = "gstreamer1.0 gstreamer1.0-plugins-base libeigen fmt nlohmann-json highway tl-expected"

inherit meson pkgconfig

PACKAGECONFIG ??= ""
PACKAGECONFIG[draw] = "-Ddraw=enabled,-Ddraw=disabled,cairo"
PACKAGECONFIG[text] = "-Dtext=enabled,-Dtext=disabled,pango"
PACKAGECONFIG[formats] = "-Dformats=enabled,-Dformats=disabled,yaml-cpp pugixml tomlplusplus"
PACKAGECONFIG[v4l2] = "-Dv4l2=enabled,-Dv4l2=disabled"
PACKAGECONFIG[tools] = "-Dexamples=true,-Dexamples=false"

EXTRA_OEMESON = "-Dopencv=disabled -Dapriltag=disabled -Dtests=false"

# The plugin holds what it uses of the library: a device that only runs pipelines needs no more than
# gstreamer1.0-calvin.
PACKAGES =+ "gstreamer1.0-calvin calvin-tools"
FILES:gstreamer1.0-calvin = "${libdir}/gstreamer-1.0/*.so ${datadir}/gstreamer-1.0/presets"
FILES:calvin-tools = "${bindir}/calvin-*"
