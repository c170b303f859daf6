// Shader programs, and the error if a driver rejects one.
#include "gl/device/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gl/device/context.h"
#include "gl/shaders.h"
#include "support/error_of.h"

namespace sdm::gl {
namespace {

using test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr ShaderSource kVertex{"good.vert",
                               "#version 450 core\nuniform float size;\nout float x;\n"
                               "void main() { x = size; gl_Position = vec4(size); }\n"};
constexpr ShaderSource kFragment{
    "good.frag", "#version 450 core\nin float x;\nout vec4 colour;\nvoid main() { colour = vec4(x); }\n"};

struct GlProgram : ::testing::Test {
  Context context{""};
  Context::Current current{context};

  void expect_refusal(const ShaderSource& vertex, const ShaderSource& fragment, const std::string& file,
                      const std::string& quote) const {
    EXPECT_THAT(error_of([&] { Program(vertex, fragment); }),
                AllOf(HasSubstr(file), HasSubstr(quote), HasSubstr(context.device().name),
                      HasSubstr("choose another device"), Not(HasSubstr("\n"))));
    context.check("compiling what does not compile");
  }
};

TEST_F(GlProgram, EngineProgramsCompileAndLink) {
  const Program polygons(kSitePolygonVert, kSitePolygonFrag), points(kTexelPointsVert, kTexelPointsFrag);
  EXPECT_TRUE(glIsProgram(polygons.id()));
  EXPECT_TRUE(glIsProgram(points.id()));
  context.check("compiling");
}

TEST_F(GlProgram, FindsTheActiveUniforms) {
  const Program program(kVertex, kFragment);
  EXPECT_GE(program.uniform("size"), 0);
  EXPECT_THAT(error_of([&] { return program.uniform("colour"); }), HasSubstr("colour"));
}

TEST_F(GlProgram, CompileErrorNamesTheShaderAndQuotesTheLog) {
  constexpr std::string_view kText = "#version 450 core\nvoid main() { no_such_function(); }\n";
  expect_refusal({"bad.vert", kText}, kFragment, "bad.vert", "no_such_function");
  expect_refusal(kVertex, {"bad.frag", kText}, "bad.frag", "no_such_function");
  // No empty text: some drivers accept it.
  expect_refusal(kVertex, {"open.frag", "#version 450 core\nvoid main() {\n"}, "open.frag", "(");
  expect_refusal(kVertex, {"new.frag", "#version 990 core\nvoid main() {}\n"}, "new.frag", "(");
}

TEST_F(GlProgram, LongLogsAreTruncated) {
  std::string text = "#version 450 core\nvoid main() {\n";
  for (int i = 0; i < 1000; ++i) text += "unknown_" + std::to_string(i) + " = 1;\n";
  const std::string error = error_of([&] { Program({"bad.vert", text + "}\n"}, kFragment); });
  EXPECT_THAT(error, AllOf(HasSubstr("unknown_0"), HasSubstr("choose another device")));
  EXPECT_LT(error.size(), 2000u);
}

TEST_F(GlProgram, LinkErrorNamesBothShaders) {
  constexpr ShaderSource kOther{
      "other.frag", "#version 450 core\nin vec3 missing;\nout vec4 c;\nvoid main() { c = missing.xyzz; }\n"};
  expect_refusal(kVertex, kOther, "good.vert", "missing");
  expect_refusal(kVertex, kOther, "other.frag", "missing");
}

TEST_F(GlProgram, ReleasesItsObjects) {
  GLuint id = 0;
  {
    const Program program(kVertex, kFragment);
    id = program.id();
  }
  EXPECT_FALSE(glIsProgram(id));
  for (GLuint i = 1; i < id + 10; ++i) EXPECT_FALSE(glIsShader(i)) << i;
}

}  // namespace
}  // namespace sdm::gl
