#include "daemon/exchange/estop_datagrams.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "daemon/clients/link_socket.hpp"
#include "daemon/temp_dir.hpp"
#include "link/estop_datagram.hpp"
#include "link/run_dir.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::estop_datagrams_test {
namespace {

class EstopDatagramsTest : public ::testing::Test {
 protected:
  TempDir folder;
  LinkSocket socket = LinkSocket::listen(folder.path(), "hero").value();
  EstopDatagrams estops{socket.estopDescriptor()};
  link::EstopDatagram client = link::EstopDatagram::to(socket.path());
};

TEST_F(EstopDatagramsTest, NothingIsTakenWhenNobodyAsked) { EXPECT_FALSE(estops.take()); }

TEST_F(EstopDatagramsTest, TheOneWhoAskedIsNamed) {
  ASSERT_TRUE(client.send("pult"));
  const auto asked = estops.take();
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->view(), "pult");
  EXPECT_FALSE(estops.take()) << "once";
}

TEST_F(EstopDatagramsTest, ANameThatIsTooLongIsCutAndNoneIsAnEstopToo) {
  ASSERT_TRUE(client.send(std::string(1000, 'n')));
  EXPECT_EQ(estops.take()->view(), std::string(31, 'n'));
  ASSERT_TRUE(client.send(""));
  EXPECT_TRUE(estops.take());
}

TEST_F(EstopDatagramsTest, AFloodIsTakenInBoundedPartsAndAFullQueueIsAnEstop) {
  for (int i = 0; i < 10'000; ++i) ASSERT_TRUE(client.send("flood"));
  const AllocGuard guard;
  int looks = 0;
  while (estops.take()) ++looks;
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_GT(looks, 1);
}

TEST_F(EstopDatagramsTest, ItsSocketHasTheRightsOfTheLinkSocketAndGoesWithIt) {
  const std::string path = link::estopPath(socket.path());
  struct stat file {};
  ASSERT_EQ(::stat(path.c_str(), &file), 0);
  EXPECT_EQ(file.st_mode & 0777U, 0660U);
  { const LinkSocket ends = std::move(socket); }
  EXPECT_NE(::stat(path.c_str(), &file), 0);
  EXPECT_FALSE(link::EstopDatagram::to(path).send("late"));
}

}  // namespace
}  // namespace rc10::test::estop_datagrams_test
