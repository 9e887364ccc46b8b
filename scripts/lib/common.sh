# shellcheck shell=bash
# What the scripts of this folder share. Source it from bash; it changes to no folder and writes nothing.

set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
build_dir="${root}/build"

# The distribution's own tools first: another python3 (pyenv, conda) lacks catkin's modules.
export PATH="/usr/sbin:/usr/bin:/sbin:/bin:${PATH:-}"
# The one UTF-8 locale that every machine has.
export LC_ALL=C.UTF-8
# Reading a script must not leave compiled files beside it.
export PYTHONDONTWRITEBYTECODE=1

fail()
{
  printf '%s: error: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# The distribution as the files in scripts/dependencies name it, for example debian-12; "unknown" without /etc/os-release.
distribution()
{
  if [ -r /etc/os-release ]; then
    # shellcheck source=/dev/null
    (. /etc/os-release && printf '%s-%s\n' "${ID:-unknown}" "${VERSION_ID:-unknown}")
  else
    printf 'unknown\n'
  fi
}

# dependencies FILE [SECTION...]: the packages of these sections, of all without one, one a line.
dependencies()
{
  local file="$1"
  shift
  awk -v wanted=" $* " '
    /^[[:space:]]*(#|$)/ { next }
    /^\[.*\]$/ { section = substr($0, 2, length($0) - 2); next }
    wanted ~ /^ +$/ || index(wanted, " " section " ") { print $1 }
  ' "${file}"
}

# source_setup FILE: a setup.bash of catkin, which reads variables that are not set.
source_setup()
{
  [ -f "$1" ] || fail "$1 is missing: build first (scripts/build)"
  set +u
  # shellcheck source=/dev/null
  . "$1"
  set -u
}

# The environment of a fresh login: what a workspace sourced earlier left behind could stand in for what this package lacks.
clean_ros_environment()
{
  unset CMAKE_PREFIX_PATH ROS_PACKAGE_PATH PYTHONPATH LD_LIBRARY_PATH PKG_CONFIG_PATH ROS_MASTER_URI ROS_IP ROS_ROOT \
    ROS_ETC_DIR ROS_NAMESPACE ROSLISP_PACKAGE_DIRECTORIES ROS_DISTRO ROS_VERSION ROS_PYTHON_VERSION CATKIN_SHELL _CATKIN_SETUP_DIR
  # Debian's ROS lies under /usr and needs no setup; Ubuntu's has one.
  if [ -f /opt/ros/noetic/setup.bash ]; then
    source_setup /opt/ros/noetic/setup.bash
  fi
  export ROS_HOSTNAME=localhost
}

# private_ros_files DIR: logs, caches and temporary files go below DIR and nowhere else.
private_ros_files()
{
  export HOME="$1/home" ROS_HOME="$1/ros" ROS_LOG_DIR="$1/ros/log" XDG_CACHE_HOME="$1/cache" MPLCONFIGDIR="$1/cache/matplotlib" TMPDIR="$1/tmp"
  mkdir -p "${HOME}" "${ROS_LOG_DIR}" "${MPLCONFIGDIR}" "${TMPDIR}"
}

# A port of 127.0.0.1 that nobody listens on, for a master of one's own.
free_port()
{
  /usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

# configure_and_build [-DOPTION...] TARGET...: configures build/ with Ninja, builds these targets and installs to build/install.
configure_and_build()
{
  local options=()
  while [[ "${1:-}" == -D* ]]; do
    options+=("$1")
    shift
  done
  cmake -S "${root}" -B "${build_dir}" -G Ninja -DCMAKE_INSTALL_PREFIX="${build_dir}/install" "${options[@]}" &&
    cmake --build "${build_dir}" --target "$@" &&
    cmake --install "${build_dir}" >"${build_dir}/install.log"
}
