// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// A file of `odograph run --map` or odo_map_save. Its plugin, in this process, reads and changes what is in it.
class MapFile {
 public:
  /// A key frame, in the frame of the map.
  struct View {
    Eigen::Quaterniond q_m_c;
    Eigen::Vector3d p_m;
    uint32_t epoch;  ///< key frames of one were tracked without interruption
    std::vector<Eigen::Vector3d> landmarks;
  };
  struct Anchor {
    std::string name;  ///< may be empty
    Eigen::Quaterniond q_m;
    Eigen::Vector3d p_m;
    double sigma_m;
  };
  /// What joining another map has given.
  struct Joint {
    size_t asked, recognised, agreeing;  ///< key frames of both
    Eigen::Quaterniond q_m_o;
    Eigen::Vector3d p_m_o;
    double sigma_m;                    ///< of its places in the map
    std::vector<std::string> doubled;  ///< names of its anchors that the map had already
  };

  /// `plugins`: folders to look for plugins in first. The failure says which file is damaged, foreign or later.
  static Result<MapFile> read(const std::string& path, const std::vector<std::filesystem::path>& plugins = {});
  MapFile(MapFile&&) noexcept;
  MapFile& operator=(MapFile&&) noexcept;
  ~MapFile();

  const std::string& path() const { return path_; }
  const std::string& plugin() const { return plugin_; }
  const std::string& version() const { return version_; }  ///< of the plugin that reads it
  const std::vector<View>& views() const { return views_; }
  const std::vector<Anchor>& anchors() const { return anchors_; }
  /// As written: empty if the plugin fails.
  std::vector<uint8_t> bytes() const;

  /// Adds another map of the same place. ODO_E_NOT_FOUND, and nothing changed, if it is not found in this one.
  Result<Joint> join(const MapFile& other);
  /// Leaves out key frames beside others until the file has at most so many bytes.
  Result<bool> thin(uint64_t bytes);
  /// Writes the file at once or not at all.
  Result<bool> write(const std::string& path) const;

 private:
  struct Reader;

  MapFile();
  Result<bool> open(std::span<const uint8_t> map);
  Result<bool> read_views();
  std::vector<uint8_t> map_bytes() const;
  std::vector<uint8_t> anchor_bytes() const;

  std::string path_, plugin_, version_;
  std::unique_ptr<Reader> reader_;
  std::vector<View> views_;
  std::vector<Anchor> anchors_;
};

}  // namespace odograph
