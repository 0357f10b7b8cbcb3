// SPDX-License-Identifier: Apache-2.0
//
// Destination of an output: through all kinds of links, from any working folder.
#include "sdk/host/base/output_file.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("output_file");

TEST_CASE("a link is followed from its own folder: relative, absolute, over several, and to a missing file") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "a/b");
  fs::create_directories(folder / "c");
  const fs::path file = folder / "c/out.txt";
  fs::create_symlink("../../c/out.txt", folder / "a/b/relative");
  fs::create_symlink(file, folder / "a/b/absolute");
  fs::create_symlink("a/b/relative", folder / "over_two");
  fs::create_symlink("c", folder / "folder_link");
  const fs::path before = fs::current_path();
  for (const char* name : {"a/b/relative", "a/b/absolute", "over_two", "folder_link/out.txt", "c/out.txt"})
    for (const bool exists : {false, true})
      for (const bool from_folder : {false, true}) {
        CAPTURE(name);
        CAPTURE(exists);
        fs::remove(file);
        if (exists) write_text(file, "old");
        if (from_folder) fs::current_path(folder.path());
        const bool written = write_whole_file(from_folder ? fs::path(name) : folder / name, "new").ok();
        fs::current_path(before);
        REQUIRE(written);
        CHECK(read_text(file) == "new");
        CHECK(fs::is_symlink(folder / "over_two"));
        CHECK_FALSE(fs::exists(folder / "c/out.txt.part"));
      }
  CHECK_FALSE(write_whole_file(folder / "none/a.txt", "x").ok());
  CHECK(write_whole_file("/dev/null", "x").ok());
}

TEST_CASE("a chain of 39 links is followed") {
  const TemporaryFolder folder;
  fs::path last = "out.txt";
  for (int i = 0; i < 39; ++i) {
    const std::string name = "link" + std::to_string(i);
    fs::create_symlink(last, folder / name);
    last = name;
  }
  REQUIRE(write_whole_file(folder / last.string(), "new").ok());
  CHECK(read_text(folder / "out.txt") == "new");
}

TEST_CASE("a new file is written beside its destination or in place, as requested, and an existing one always beside") {
  for (const auto beside : {OutputFile::PartFile::always, OutputFile::PartFile::if_exists})
    for (const bool exists : {false, true}) {
      const TemporaryFolder folder;
      const fs::path file = folder / "out.txt";
      if (exists) write_text(file, "old");
      write_text(folder / "stranger", "theirs");
      fs::create_symlink("stranger", folder / "out.txt.part");
      auto out = required(OutputFile::create(file, beside));
      const bool apart = exists || beside == OutputFile::PartFile::always;
      CHECK((fs::is_regular_file(fs::symlink_status(folder / "out.txt.part"))) == apart);
      CHECK(fs::exists(file) == (exists || !apart));
      OutputFile moved(std::move(*out));
      moved.stream() << "new";
      REQUIRE(moved.commit().ok());
      CHECK(read_text(file) == "new");
      CHECK(read_text(folder / "stranger") == "theirs");
    }
}

TEST_CASE("abandoned output stays, and dropped output beside an existing file is removed") {
  const TemporaryFolder folder;
  const fs::path file = write_text(folder / "out.txt", "old");
  { OutputFile::create(file)->stream() << "dropped"; }
  CHECK_FALSE(fs::exists(folder / "out.txt.part"));
  {
    auto out = OutputFile::create(file);
    out->stream() << "kept";
    out->abandon();
  }
  CHECK(read_text(folder / "out.txt.part") == "kept");
  CHECK(read_text(file) == "old");
}

TEST_CASE("two writers of one destination exclude each other, in either mode and through links") {
  using PartFile = OutputFile::PartFile;
  for (const auto first : {PartFile::always, PartFile::if_exists})
    for (const auto second : {PartFile::always, PartFile::if_exists})
      for (const bool exists : {false, true}) {
        const TemporaryFolder folder;
        const fs::path file = folder / "out.txt";
        fs::create_symlink("out.txt", folder / "link");
        if (exists) write_text(file, "old");
        {
          auto out = required(OutputFile::create(file, first));
          out->stream() << "first";
          for (const fs::path& name : {file, folder / "link"}) {
            const auto other = OutputFile::create(name, second);
            REQUIRE_FALSE(other.ok());
            CHECK(other.failure().status == ODO_E_STATE);
            CHECK(contains(other.failure().text, "is being written by another"));
          }
          REQUIRE(out->commit().ok());
          CHECK(read_text(file) == "first");
        }
        CHECK(OutputFile::create(file, second).ok());
      }
}
