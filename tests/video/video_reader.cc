#include "tests/video/video_reader.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <set>
#include <stdexcept>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
}

namespace gauntlet::sim {
namespace {

void Check(int result, const char* what) {
  if (result < 0) throw std::runtime_error(what);
}

double MeanBrightness(const AVFrame& frame, int begin, int end) {
  double sum = 0.0;
  for (int y = 0; y < frame.height; ++y) {
    for (int x = begin; x < end; ++x) sum += frame.data[0][y * frame.linesize[0] + x];
  }
  return sum / (frame.height * (end - begin));
}

std::size_t Colours(const AVFrame& frame) {
  std::set<std::uint32_t> colours;
  for (int y = 0; y < frame.height; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(frame.data[0] + y * frame.linesize[0]);
    colours.insert(row, row + frame.width);
  }
  return colours.size();
}

struct Decoder {
  AVFormatContext* container = nullptr;
  AVCodecContext* codec = nullptr;
  AVFrame* frame = av_frame_alloc();
  AVPacket* packet = av_packet_alloc();

  ~Decoder() {
    av_packet_free(&packet);
    av_frame_free(&frame);
    avcodec_free_context(&codec);
    avformat_close_input(&container);
  }

  void ReadFrames(VideoContent& content, const AVStream& stream) {
    while (avcodec_receive_frame(codec, frame) >= 0) {
      const double time_s = frame->pts * av_q2d(stream.time_base);
      if (std::abs(time_s * content.frames_per_s - content.frames) > 1e-6) {
        content.times_are_even = false;
      }
      content.brightness.push_back({MeanBrightness(*frame, 0, frame->width / 2),
                                    MeanBrightness(*frame, frame->width / 2, frame->width)});
      if (frame->format == AV_PIX_FMT_BGRA) content.colours.push_back(Colours(*frame));
      ++content.frames;
    }
  }
};

}  // namespace

VideoContent ReadVideo(const std::filesystem::path& file) {
  Decoder decoder;
  Check(avformat_open_input(&decoder.container, file.c_str(), nullptr, nullptr), "open");
  Check(avformat_find_stream_info(decoder.container, nullptr), "streams");
  // MP4 has chapters as a text of their own beside the video.
  const bool has_chapters = decoder.container->nb_chapters > 0;
  if (decoder.container->nb_streams > (has_chapters ? 2u : 1u)) {
    throw std::runtime_error("too many streams");
  }
  const AVStream& stream = *decoder.container->streams[0];
  const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
  decoder.codec = avcodec_alloc_context3(codec);
  Check(avcodec_parameters_to_context(decoder.codec, stream.codecpar), "parameters");
  Check(avcodec_open2(decoder.codec, codec, nullptr), "decoder");

  VideoContent content{.codec = avcodec_get_name(stream.codecpar->codec_id),
                       .pixel_format = av_get_pix_fmt_name(decoder.codec->pix_fmt),
                       .color_space = av_color_space_name(decoder.codec->colorspace),
                       .width_px = stream.codecpar->width,
                       .height_px = stream.codecpar->height,
                       .frames_per_s = av_q2d(stream.avg_frame_rate)};
  for (unsigned i = 0; i < decoder.container->nb_chapters; ++i) {
    const AVChapter& chapter = *decoder.container->chapters[i];
    const AVDictionaryEntry* title = av_dict_get(chapter.metadata, "title", nullptr, 0);
    content.chapters.push_back({.title = title != nullptr ? title->value : "",
                                .begin_s = chapter.start * av_q2d(chapter.time_base),
                                .end_s = chapter.end * av_q2d(chapter.time_base)});
  }
  while (av_read_frame(decoder.container, decoder.packet) >= 0) {
    if (decoder.packet->stream_index != stream.index) {
      av_packet_unref(decoder.packet);
      continue;
    }
    Check(avcodec_send_packet(decoder.codec, decoder.packet), "decode");
    av_packet_unref(decoder.packet);
    decoder.ReadFrames(content, stream);
  }
  Check(avcodec_send_packet(decoder.codec, nullptr), "decode");
  decoder.ReadFrames(content, stream);
  return content;
}

std::vector<std::string> BoxesOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::string> names;
  unsigned char head[8];
  while (stream.read(reinterpret_cast<char*>(head), sizeof(head))) {
    const std::uint32_t size = head[0] << 24 | head[1] << 16 | head[2] << 8 | head[3];
    names.emplace_back(head + 4, head + 8);
    if (size < 8) throw std::runtime_error("a box of unusual size");
    stream.seekg(size - 8, std::ios::cur);
  }
  return names;
}

}  // namespace gauntlet::sim
